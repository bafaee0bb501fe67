//! The elements of accessors; every length is checked before it is used.

use std::collections::HashMap;

use ::gltf::json::{
    Index, Root,
    accessor::{ComponentType, Type as Dimensions, sparse::Sparse},
    buffer::View,
    validation::Checked,
};
use glam::{DAffine3, DMat4, Vec3};

use super::{Problem, container::Container, item};

/// What elements are made of that are stored nowhere: a matrix of f32 is the largest.
const ZEROS: [u8; 64] = [0; 64];

impl Container<'_> {
    /// The elements of an accessor, if it is of a wanted type and lies within its buffer.
    pub(super) fn elements(
        &self,
        root: &Root,
        index: usize,
        (dimensions, kinds): (Dimensions, &[ComponentType]),
        what: &str,
    ) -> Result<Elements<'_>, Problem> {
        let accessor = item(&root.accessors, index, "accessor")?;
        let wrong = |problem: &str| format!("accessor {index} ({what}) {problem}");
        let beyond =
            || wrong("reaches beyond the end of its buffer: the file is damaged or cut short");
        let kind = match (accessor.component_type, accessor.type_) {
            (Checked::Valid(kind), Checked::Valid(is)) if is == dimensions => kind.0,
            _ => return Err(wrong("is of the wrong type")),
        };
        if !kinds.contains(&kind) {
            return Err(wrong("is of the wrong type"));
        }
        let is_share = accessor.normalized;
        let size = kind.size() * dimensions.multiplicity();
        let count = usize::try_from(accessor.count.0).unwrap_or(usize::MAX);
        let (bytes, stride) = match accessor.buffer_view {
            None => (&ZEROS[..], 0),
            Some(view) => {
                let (bytes, stride) = self.view(root, view)?;
                let stride = stride.unwrap_or(size);
                if stride < size {
                    return Err(wrong(&format!(
                        "has a byteStride of {stride}, less than its elements of {size} bytes; export the file again"
                    )));
                }
                let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
                (from(bytes, offset, count, (stride, size)).ok_or_else(beyond)?, stride)
            }
        };
        let mut elements = Elements {
            bytes,
            stride,
            kind,
            is_share,
            size,
            count,
            replaced: HashMap::new(),
            others: &[],
        };
        if let Some(sparse) = &accessor.sparse {
            self.replace(root, sparse, &mut elements)?.ok_or_else(beyond)?;
            if elements.replaced.keys().any(|&element| element >= count) {
                return Err(wrong(
                    "replaces elements that it does not have; export the file again",
                ));
            }
        }
        Ok(elements)
    }

    /// Takes those elements from elsewhere that a sparse accessor replaces; `None` if they reach beyond their buffer.
    fn replace<'a>(
        &'a self,
        root: &Root,
        sparse: &Sparse,
        elements: &mut Elements<'a>,
    ) -> Result<Option<()>, Problem> {
        let Checked::Valid(kind) = sparse.indices.component_type else {
            return Err("the indices of a sparse accessor are of the wrong type".to_owned());
        };
        let (kind, size) = (kind.0, kind.0.size());
        let count = usize::try_from(sparse.count.0).unwrap_or(usize::MAX);
        let (indices, _) = self.view(root, sparse.indices.buffer_view)?;
        let (values, _) = self.view(root, sparse.values.buffer_view)?;
        let indices = from(indices, sparse.indices.byte_offset.0, count, (size, size));
        let sizes = (elements.size, elements.size);
        let values = from(values, sparse.values.byte_offset.0, count, sizes);
        let (Some(bytes), Some(values)) = (indices, values) else { return Ok(None) };
        let (replaced, others) = (HashMap::new(), &[][..]);
        let indices =
            Elements { bytes, stride: size, kind, is_share: false, size, count, replaced, others };
        elements.replaced = (0..count).map(|place| (indices.index(place), place)).collect();
        elements.others = values;
        Ok(Some(()))
    }

    /// The bytes of a buffer view, and how far its elements are apart, if it says so.
    fn view(&self, root: &Root, view: Index<View>) -> Result<(&[u8], Option<usize>), Problem> {
        let index = view.value();
        let view = item(&root.buffer_views, index, "buffer view")?;
        let buffer = self.buffer(view.buffer.value())?;
        let start = view.byte_offset.map_or(0, |offset| offset.0);
        let bytes = slice(buffer, start, view.byte_length.0).ok_or_else(|| {
            format!("buffer view {index} reaches beyond the end of its buffer: the file is damaged or cut short")
        })?;
        // Some programs write 0 where there is none.
        let stride = view.byte_stride.map(|stride| stride.0).filter(|&stride| stride > 0);
        Ok((bytes, stride))
    }
}

fn slice(bytes: &[u8], start: u64, length: u64) -> Option<&[u8]> {
    let start = usize::try_from(start).ok()?;
    bytes.get(start..start.checked_add(usize::try_from(length).ok()?)?)
}

/// The bytes from `offset`, if they hold so many elements.
fn from(bytes: &[u8], offset: u64, count: usize, (stride, size): (usize, usize)) -> Option<&[u8]> {
    let bytes = bytes.get(usize::try_from(offset).ok()?..)?;
    let needed = match count {
        0 => 0,
        _ => (count - 1).checked_mul(stride)?.checked_add(size)?,
    };
    (needed <= bytes.len()).then_some(bytes)
}

/// Elements of one accessor: checked, so reading one cannot fail.
pub(super) struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    kind: ComponentType,
    /// Whether integers stand for shares of the largest one.
    is_share: bool,
    /// Bytes of one element.
    size: usize,
    pub(super) count: usize,
    /// The elements that are among the others, and their places there.
    replaced: HashMap<usize, usize>,
    others: &'a [u8],
}

impl Elements<'_> {
    fn component(&self, element: usize, component: usize) -> [u8; 4] {
        let (source, start) = match self.replaced.get(&element) {
            Some(place) => (self.others, place * self.size),
            None => (self.bytes, element * self.stride),
        };
        let size = self.kind.size();
        let at = start + component * size;
        let mut bytes = [0; 4];
        bytes[..size].copy_from_slice(&source[at..at + size]);
        bytes
    }

    /// A vector of three numbers.
    pub(super) fn vector(&self, element: usize) -> Vec3 {
        Vec3::from_array([0, 1, 2].map(|axis| self.number(element, axis)))
    }

    fn number(&self, element: usize, component: usize) -> f32 {
        let bytes = self.component(element, component);
        let [first, second, ..] = bytes;
        let (integer, largest): (f32, f32) = match self.kind {
            ComponentType::I8 => (first.cast_signed().into(), i8::MAX.into()),
            ComponentType::U8 => (first.into(), u8::MAX.into()),
            ComponentType::I16 => (i16::from_le_bytes([first, second]).into(), i16::MAX.into()),
            ComponentType::U16 => (u16::from_le_bytes([first, second]).into(), u16::MAX.into()),
            _ => return f32::from_le_bytes(bytes),
        };
        if self.is_share { (integer / largest).max(-1.0) } else { integer }
    }

    /// An affine map of sixteen f32.
    pub(super) fn affine(&self, element: usize) -> DAffine3 {
        let at = |place| f64::from(f32::from_le_bytes(self.component(element, place)));
        DAffine3::from_mat4(DMat4::from_cols_array(&std::array::from_fn(at)))
    }

    /// Unsigned integers of one, two or four bytes.
    pub(super) fn integer(&self, element: usize, component: usize) -> usize {
        u32::from_le_bytes(self.component(element, component)) as usize
    }

    /// The only integer of an element.
    pub(super) fn index(&self, element: usize) -> usize {
        self.integer(element, 0)
    }

    /// A share: f32, or an integer of which the largest is 1.
    pub(super) fn share(&self, element: usize, component: usize) -> f64 {
        let largest = match self.kind {
            ComponentType::U8 => f64::from(u8::MAX),
            ComponentType::U16 => f64::from(u16::MAX),
            _ => return f32::from_le_bytes(self.component(element, component)).into(),
        };
        self.integer(element, component) as f64 / largest
    }
}
