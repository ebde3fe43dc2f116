"""What VRM adds to glTF: the body of a humanoid, its face, eyes, hair and toon shading."""
