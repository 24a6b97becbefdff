"""Teaching the RGB-D tracker what people look like."""
