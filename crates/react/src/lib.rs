//! What becomes of a verdict: reports as text, JSON, NDJSON and JUnit.
