"""What may be wrong with the content of a recording; one idea a file."""
