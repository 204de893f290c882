"""Unoriented points of a CAD part in, a clean watertight mesh out."""
