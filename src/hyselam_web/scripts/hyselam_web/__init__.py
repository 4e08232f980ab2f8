"""A page in the browser for a robot of this stack. All but robot.py is free of ROS."""
