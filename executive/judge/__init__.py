"""What a run is judged by: expectations, temporal logic, safety."""
