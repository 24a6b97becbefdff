"""People tracked by what a learned detector proposes: any camera, any room."""
