//! Writes CDR, the encoding of ROS 2: little-endian, every number at a multiple of its size.

/// The first four bytes of every message: plain CDR, little-endian.
const HEAD: [u8; 4] = [0, 1, 0, 0];

/// A message being written. Its buffer is used again for the next one.
#[derive(Debug, Default)]
pub struct Cdr {
    bytes: Vec<u8>,
}

impl Cdr {
    /// Begins a message.
    pub fn begin(&mut self) {
        self.bytes.clear();
        self.bytes.extend(HEAD);
    }

    /// The message.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    fn align(&mut self, size: usize) {
        // Counted from behind the head.
        let over = (self.bytes.len() - HEAD.len()) % size;
        if over > 0 {
            self.bytes.resize(self.bytes.len() + size - over, 0);
        }
    }

    /// One byte.
    pub fn u8(&mut self, value: u8) {
        self.bytes.push(value);
    }

    /// A truth value.
    pub fn bool(&mut self, value: bool) {
        self.u8(u8::from(value));
    }

    /// An integer of 32 bits without a sign.
    pub fn u32(&mut self, value: u32) {
        self.align(4);
        self.bytes.extend(value.to_le_bytes());
    }

    /// An integer of 32 bits.
    pub fn i32(&mut self, value: i32) {
        self.align(4);
        self.bytes.extend(value.to_le_bytes());
    }

    /// A number of 32 bits.
    pub fn f32(&mut self, value: f32) {
        self.align(4);
        self.bytes.extend(value.to_le_bytes());
    }

    /// Numbers of 64 bits, one after the other.
    pub fn f64s(&mut self, values: &[f64]) {
        if values.is_empty() {
            return;
        }
        self.align(8);
        values.iter().for_each(|v| self.bytes.extend(v.to_le_bytes()));
    }

    /// How many elements an array has that follows.
    pub fn count(&mut self, count: usize) {
        self.u32(u32::try_from(count).unwrap_or(u32::MAX));
    }

    /// An array of numbers of 32 bits.
    pub fn array_f32(&mut self, values: &[f32]) {
        self.count(values.len());
        values.iter().for_each(|v| self.bytes.extend(v.to_le_bytes()));
    }

    /// An array of numbers of 64 bits.
    pub fn array_f64(&mut self, values: &[f64]) {
        self.count(values.len());
        self.f64s(values);
    }

    /// A text, with the zero at its end.
    pub fn text(&mut self, text: &str) {
        self.count(text.len() + 1);
        self.bytes.extend(text.bytes());
        self.bytes.push(0);
    }

    /// An array of texts.
    pub fn texts<'t>(&mut self, texts: impl ExactSizeIterator<Item = &'t str>) {
        self.count(texts.len());
        texts.for_each(|t| self.text(t));
    }
}
