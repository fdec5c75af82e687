"""What `longarm.yaml` names here; the package, once installed, names `yard_robot.plugin` itself."""

from yard_robot.plugin import *  # noqa: F403
from yard_robot.plugin import __all__ as __all__
