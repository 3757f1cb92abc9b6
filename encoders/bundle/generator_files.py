"""The files of a bundle that motions are generated with; none of them changes an embedding, and any may be missing."""

#: The motion decoder; the Gaussian of a sentence by its vector, where text.onnx gives none; the Gaussians of labels.
DECODER, SENTENCES, LABELS = "decoder.onnx", "sentences.onnx", "labels.npz"
