//! Numbers, texts and values as bytes, for snapshots and recorded inputs.

use crate::carried::{BodyHistory, Kept};
use crate::error::WorldError;
use crate::path_faults::{Promised, SnapshotFault};
use opruga_core::history::Content;
use opruga_core::spec::Value;
use opruga_core::state::Columns;
use opruga_core::system::System;

/// The types of the channels of a history.
const NUMBER: u64 = 0;
const COUNT: u64 = 1;
const FLAG: u64 = 2;
const VECTORS: u64 = 3;

/// Writes little-endian numbers, one after another.
pub(crate) struct Writer<'a>(pub(crate) &'a mut Vec<u8>);

impl Writer<'_> {
    pub(crate) fn count(&mut self, n: u64) {
        self.0.extend(n.to_le_bytes());
    }
    pub(crate) fn number(&mut self, x: f64) {
        self.0.extend(x.to_le_bytes());
    }
    pub(crate) fn text(&mut self, text: &str) {
        self.count(text.len() as u64);
        self.0.extend(text.as_bytes());
    }
    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        self.count(bytes.len() as u64);
        self.0.extend(bytes);
    }
    pub(crate) fn numbers(&mut self, numbers: &[f64]) {
        self.count(numbers.len() as u64);
        numbers.iter().for_each(|x| self.number(*x));
    }
    pub(crate) fn value(&mut self, value: &Value) {
        match value {
            Value::Number(x) => {
                self.count(0);
                self.number(*x);
            }
            Value::Integer(n) => {
                self.count(1);
                self.count(*n as u64);
            }
            Value::Boolean(b) => {
                self.count(2);
                self.count(u64::from(*b));
            }
            Value::Text(text) => {
                self.count(3);
                self.text(text);
            }
            Value::Numbers(numbers) => {
                self.count(4);
                self.numbers(numbers);
            }
            Value::Integers(numbers) => {
                self.count(5);
                self.count(numbers.len() as u64);
                numbers.iter().for_each(|n| self.count(u64::from(*n)));
            }
            Value::Rows(rows) => {
                self.count(6);
                self.count(rows.len() as u64);
                rows.iter().for_each(|row| self.numbers(row));
            }
        }
    }
    pub(crate) fn vectors<const D: usize>(&mut self, vectors: &[[f64; D]]) {
        self.count(vectors.len() as u64);
        for x in vectors.iter().flatten() {
            self.number(*x);
        }
    }
    /// Writes the history that the integrator keeps for one body.
    pub(crate) fn history<const D: usize>(&mut self, system: &System<D>, lane: usize) {
        self.text(system.history.owner());
        let channels = system.history.channels();
        self.count(channels.len() as u64);
        for (channel, content) in channels {
            self.text(channel.name);
            match content {
                Content::Number(number) => {
                    self.count(NUMBER);
                    self.number(*number);
                }
                Content::Count(count) => {
                    self.count(COUNT);
                    self.count(*count);
                }
                Content::Flag(flag) => {
                    self.count(FLAG);
                    self.count(u64::from(*flag));
                }
                Content::Vectors(columns) => {
                    self.count(VECTORS);
                    self.columns(columns, system, lane);
                }
            }
        }
    }
    /// Writes the vectors of the nodes of one body. Memory is reserved once, because these vectors make up most of a snapshot.
    pub(crate) fn columns<const D: usize>(&mut self, columns: &Columns<D>, system: &System<D>, lane: usize) {
        self.count(system.nodes as u64);
        let from = self.0.len();
        self.0.resize(from + system.nodes * D * 8, 0);
        let (bytes, _) = self.0[from..].as_chunks_mut::<8>();
        let (nodes, _) = bytes.as_chunks_mut::<D>();
        for (node, to) in nodes.iter_mut().enumerate() {
            *to = columns.at(system.layout.index(node, lane)).map(f64::to_le_bytes);
        }
    }
}

pub(crate) struct Reader<'a>(pub(crate) &'a [u8]);

impl<'a> Reader<'a> {
    pub(crate) fn bytes(&mut self) -> Result<&'a [u8], WorldError> {
        let n = self.count()?;
        let promised = || WorldError::snapshot(SnapshotFault::Promises { count: n, what: Promised::Bytes });
        let n = usize::try_from(n).map_err(|_| promised())?;
        let (head, tail) = self.0.split_at_checked(n).ok_or_else(promised)?;
        self.0 = tail;
        Ok(head)
    }
}

impl Reader<'_> {
    pub(crate) fn eight(&mut self) -> Result<[u8; 8], WorldError> {
        let (head, tail) =
            self.0.split_first_chunk::<8>().ok_or_else(|| WorldError::snapshot(SnapshotFault::EndsEarly {}))?;
        self.0 = tail;
        Ok(*head)
    }
    pub(crate) fn count(&mut self) -> Result<u64, WorldError> {
        Ok(u64::from_le_bytes(self.eight()?))
    }
    /// Reads a count of items of at least eight bytes each. Refuses a count for which too few bytes remain.
    pub(crate) fn length(&mut self) -> Result<usize, WorldError> {
        let n = self.count()?;
        if n > self.0.len() as u64 / 8 {
            return Err(WorldError::snapshot(SnapshotFault::Promises { count: n, what: Promised::Numbers }));
        }
        Ok(n as usize)
    }
    pub(crate) fn number(&mut self) -> Result<f64, WorldError> {
        Ok(f64::from_le_bytes(self.eight()?))
    }
    pub(crate) fn text(&mut self) -> Result<String, WorldError> {
        let n = self.count()?;
        let promised = || WorldError::snapshot(SnapshotFault::Promises { count: n, what: Promised::Letters });
        let n = usize::try_from(n).map_err(|_| promised())?;
        let (head, tail) = self.0.split_at_checked(n).ok_or_else(promised)?;
        self.0 = tail;
        String::from_utf8(head.to_vec()).map_err(|_| WorldError::snapshot(SnapshotFault::Text {}))
    }
    pub(crate) fn numbers(&mut self) -> Result<Vec<f64>, WorldError> {
        let n = self.length()?;
        (0..n).map(|_| self.number()).collect()
    }
    pub(crate) fn value(&mut self) -> Result<Value, WorldError> {
        Ok(match self.count()? {
            0 => Value::Number(self.number()?),
            1 => Value::Integer(self.count()? as i64),
            2 => Value::Boolean(self.count()? == 1),
            3 => Value::Text(self.text()?),
            4 => Value::Numbers(self.numbers()?),
            5 => {
                let n = self.length()?;
                Value::Integers((0..n).map(|_| Ok(self.count()? as u32)).collect::<Result<_, WorldError>>()?)
            }
            6 => {
                let n = self.length()?;
                Value::Rows((0..n).map(|_| self.numbers()).collect::<Result<_, _>>()?)
            }
            _ => return Err(WorldError::snapshot(SnapshotFault::Value {})),
        })
    }
    pub(crate) fn history<const D: usize>(&mut self) -> Result<BodyHistory<D>, WorldError> {
        let mut history = BodyHistory { owner: self.text()?, channels: Vec::new() };
        for _ in 0..self.length()? {
            let name = self.text()?;
            let kept = match self.count()? {
                NUMBER => Kept::Number(self.number()?),
                COUNT => Kept::Count(self.count()?),
                FLAG => Kept::Flag(self.count()? != 0),
                VECTORS => Kept::Vectors(self.vectors::<D>()?),
                _ => return Err(WorldError::snapshot(SnapshotFault::Channel { channel: name })),
            };
            let numbers = match &kept {
                Kept::Number(number) => std::slice::from_ref(number),
                Kept::Vectors(vectors) => vectors.as_flattened(),
                Kept::Count(_) | Kept::Flag(_) => &[],
            };
            if let Some(invalid) = numbers.iter().find(|x| !x.is_finite()) {
                return Err(WorldError::snapshot(SnapshotFault::ChannelNumber { channel: name, number: *invalid }));
            }
            history.channels.push((name, kept));
        }
        Ok(history)
    }
    /// Reads the history in a snapshot of version 8, if the integrator kept nothing. Other histories of that version contained
    /// numbers without names.
    pub(crate) fn empty_history<const D: usize>(&mut self) -> Result<Option<BodyHistory<D>>, WorldError> {
        let owner = self.text()?;
        let (columns, numbers) = (self.count()?, self.count()?);
        Ok((columns == 0 && numbers == 0).then_some(BodyHistory { owner, channels: Vec::new() }))
    }
    pub(crate) fn vectors<const D: usize>(&mut self) -> Result<Vec<[f64; D]>, WorldError> {
        let n = self.length()?;
        let mut out = Vec::with_capacity(n);
        for _ in 0..n {
            let mut vector = [0.0; D];
            for x in &mut vector {
                *x = self.number()?;
            }
            out.push(vector);
        }
        Ok(out)
    }
}
