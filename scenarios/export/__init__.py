"""Export runs to the file formats of other tools: tables, and images that are rendered again."""
