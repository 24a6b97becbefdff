"""What people look like: colours of head, torso and legs, compared from frame to frame."""
