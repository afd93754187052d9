//! Maps bytes of the composed text back to the bytes of the files that they came from.

use crate::files;
use data_file::{Source, Span};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// The origin of each byte of a composed text.
#[derive(Clone, Debug, Default)]
pub(crate) struct LineMap {
    pieces: Vec<Piece>,
}

/// A run of bytes of one origin, up to the next piece.
#[derive(Clone, Debug)]
struct Piece {
    composed: u32,
    source: Arc<Source>,
    /// Where in the source.
    range: Range<u32>,
    /// Copied byte by byte; otherwise made from the whole range, to which each byte then maps.
    verbatim: bool,
}

impl LineMap {
    /// Says that the text from `composed` on is a copy of `range` of `source`.
    pub(crate) fn copied(&mut self, composed: usize, source: &Arc<Source>, range: Range<usize>) {
        self.push(composed, source, range, true);
    }

    /// Says that the text from `composed` on was made because of `range` of `source`.
    pub(crate) fn made(&mut self, composed: usize, source: &Arc<Source>, range: Range<usize>) {
        self.push(composed, source, range, false);
    }

    fn push(&mut self, composed: usize, source: &Arc<Source>, range: Range<usize>, verbatim: bool) {
        self.pieces.push(Piece {
            composed: composed as u32,
            source: source.clone(),
            range: range.start as u32..range.end as u32,
            verbatim,
        });
    }

    /// Says that copies of these ranges, each of this many bytes, stand before all else.
    pub(crate) fn prepend(&mut self, copies: &[(usize, Arc<Source>, Range<usize>)]) {
        let mut rest = std::mem::take(&mut self.pieces);
        let mut at = 0;
        for (bytes, source, range) in copies {
            self.copied(at, source, range.clone());
            at += bytes;
        }
        rest.iter_mut().for_each(|piece| piece.composed += at as u32);
        self.pieces.append(&mut rest);
    }

    /// The file and byte that the byte at `at` came from; and the range it was made from, for what was made.
    fn origin(&self, at: u32) -> Option<(&Arc<Source>, Range<u32>)> {
        let index = self.pieces.partition_point(|piece| piece.composed <= at).checked_sub(1)?;
        let piece = self.pieces.get(index)?;
        if !piece.verbatim {
            return Some((&piece.source, piece.range.clone()));
        }
        let byte = (piece.range.start + (at - piece.composed)).min(piece.range.end);
        Some((&piece.source, byte..(byte + 1).min(piece.range.end)))
    }

    /// The file that was requested as `path`, from whichever root, where anything came from it.
    pub(crate) fn source(&self, path: &str) -> Option<&Arc<Source>> {
        let path = files::normalise(path)?;
        self.pieces.iter().map(|piece| &piece.source).find(|source| Path::new(&source.name).ends_with(&path))
    }

    /// The place in the user's file of a range of the composed text. A range that runs over into another file
    /// ends with its first byte's file.
    pub(crate) fn span(&self, composed: Range<u32>) -> Option<Span> {
        let (source, first) = self.origin(composed.start)?;
        let last = composed.end.saturating_sub(1).max(composed.start);
        let end = match self.origin(last) {
            _ if composed.is_empty() => first.start,
            Some((other, range)) if Arc::ptr_eq(source, other) && range.end >= first.start => range.end,
            _ => first.end,
        };
        Some(span(source, first.start as usize..end as usize))
    }
}

/// A span of whole characters inside the text, whatever the range.
pub(crate) fn span(source: &Arc<Source>, range: Range<usize>) -> Span {
    let text = &source.text;
    let start = text.floor_char_boundary(range.start);
    let end = text.ceil_char_boundary(range.end).max(start);
    Span { source: source.clone(), start: start as u32, end: end as u32 }
}
