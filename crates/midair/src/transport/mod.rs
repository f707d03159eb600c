//! F: viewpoint, elements, plate, display; and its derivatives.
