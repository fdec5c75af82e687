"""Where the head truly looks: ground as its reference, registration of pictures, alignment."""
