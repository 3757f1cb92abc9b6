"""Stars, tags and collections: what people say of clips, in the database and in a file beside it."""
