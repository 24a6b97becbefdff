"""The RGB-D tracker of the situation-awareness thesis: a particle filter for each person on the floor."""
