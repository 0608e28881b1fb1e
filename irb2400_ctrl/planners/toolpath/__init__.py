"""What the tool shall do: way-points read or built, their smooth curve, its orientations."""
