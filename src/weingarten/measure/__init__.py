"""What a reverse engineer reads off a fitted part: planes, cylinders, cones, spheres and tori."""
