//! Findings as tables for other programs, as RFC 4180 has them.

use csv::{Writer, WriterBuilder};

/// A table under way.
pub(super) struct Table(Writer<Vec<u8>>);

impl Table {
    /// A table with the names of its columns.
    pub fn new(head: Vec<String>) -> Self {
        let mut table = Self(WriterBuilder::new().from_writer(Vec::new()));
        table.row(head);
        table
    }

    /// One more row, of as many fields as the head has.
    pub fn row(&mut self, fields: Vec<String>) {
        // Memory takes all that is written to it.
        let written = self.0.write_record(fields);
        debug_assert!(written.is_ok(), "{written:?}");
    }

    /// The table's text.
    pub fn finish(self) -> String {
        let bytes = self.0.into_inner().unwrap_or_default();
        // Only text was written.
        String::from_utf8(bytes).unwrap_or_default()
    }
}

/// A number; what is not known is empty.
pub(super) fn number(value: Option<f64>) -> String {
    value.filter(|value| value.is_finite()).map_or_else(String::new, |value| value.to_string())
}
