"""How close certified boxes are to what runs reach."""
