"""ROS 2 bags: messages of images, people and the robot, and the bag writer."""
