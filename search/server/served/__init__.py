"""What is served: a library on disk or a collection of Milvus, in one form."""
