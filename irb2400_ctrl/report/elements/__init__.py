"""What every page is made of: the page, its figures as inline SVG, the arm, where it comes from."""

__all__: list[str] = []
