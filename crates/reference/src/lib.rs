//! The language's meaning as slow, obvious code: the oracle that the engine is tested against.
