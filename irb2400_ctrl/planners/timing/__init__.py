"""When a path is where: the fastest law within the limits, and the certificate that it is."""
