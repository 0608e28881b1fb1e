"""NX CLSF, Creo NCL, CATIA aptsource and APT/CLDATA (ISO 4343)."""

__all__: list[str] = []
