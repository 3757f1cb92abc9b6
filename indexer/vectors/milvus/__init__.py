"""Milvus, where one machine is not enough: the vectors of many libraries in one collection, with what hits show."""
