//! The pictures that wait, and which of them is next.

use super::request::PictureRequest;
use ltcforge_files::digest::Digest;

/// How often a picture may be overtaken by cheaper ones that were requested after it.
const MOST_OVERTAKEN: u32 = 8;

/// The pictures that wait, in order of arrival.
#[derive(Debug, Default)]
pub(super) struct Waiting(Vec<Place>);

#[derive(Debug)]
struct Place {
    request: PictureRequest,
    cost: f64,
    /// How many pictures that were requested after it were taken before it.
    overtaken: u32,
}

impl Waiting {
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// The waiting request of `key`.
    pub(super) fn find(&mut self, key: Digest) -> Option<&mut PictureRequest> {
        self.0.iter_mut().map(|place| &mut place.request).find(|request| request.key == key)
    }

    pub(super) fn add(&mut self, request: PictureRequest) {
        self.0.push(Place { cost: request.subject.cost(), request, overtaken: 0 });
    }

    /// Removes the requests for which no caller waits any more; how many there were.
    pub(super) fn remove_withdrawn(&mut self) -> usize {
        let before = self.0.len();
        self.0.retain(|place| !place.request.is_withdrawn());
        before - self.0.len()
    }

    /// Takes the next request: the first of those that were overtaken most often if there are any, else the first of the
    /// cheapest.
    pub(super) fn take(&mut self) -> Option<PictureRequest> {
        let is_due = |place: &Place| place.overtaken >= MOST_OVERTAKEN;
        let next = self.0.iter().position(is_due).or_else(|| {
            // Of equal ones `min_by` takes the first.
            let places = self.0.iter().enumerate();
            places.min_by(|(_, a), (_, b)| a.cost.total_cmp(&b.cost)).map(|(index, _)| index)
        })?;
        for place in &mut self.0[..next] {
            place.overtaken += 1;
        }
        Some(self.0.remove(next).request)
    }

    pub(super) fn clear(&mut self) {
        self.0.clear();
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::{
        super::{
            picture::Subject,
            request::{Receipt, Reply},
        },
        *,
    };
    use ltcforge_view::preview::Scene;

    /// Adds a picture of a size, with a name of its own.
    fn add(waiting: &mut Waiting, size: u32, name: &str) -> Receipt {
        let (reply, receipt) = Reply::new();
        waiting.add(PictureRequest {
            key: Digest::of(name.as_bytes()),
            table: None,
            subject: Subject::Scene(Box::new(Scene { size, ..Scene::default() })),
            limit: Duration::from_secs(30),
            replies: vec![reply],
        });
        receipt
    }

    fn take(waiting: &mut Waiting) -> Digest {
        waiting.take().expect("a request").key
    }

    #[test]
    fn the_cheapest_picture_is_next_and_equal_ones_keep_their_order() {
        let mut waiting = Waiting::default();
        let receipts =
            [("a", 300), ("b", 100), ("c", 200), ("d", 100)].map(|(name, size)| add(&mut waiting, size, name));
        for name in ["b", "d", "c", "a"] {
            assert_eq!(take(&mut waiting), Digest::of(name.as_bytes()), "{name}");
        }
        assert!(waiting.take().is_none());
        drop(receipts);
    }

    #[test]
    fn a_picture_that_was_overtaken_eight_times_is_next() {
        let mut waiting = Waiting::default();
        // It is behind one of its own cost and one that costs more.
        let mut receipts = vec![add(&mut waiting, 300, "dear"), add(&mut waiting, 200, "dearer than the small ones")];
        for turn in 0..8 {
            let name = format!("small {turn}");
            receipts.push(add(&mut waiting, 100, &name));
            assert_eq!(take(&mut waiting), Digest::of(name.as_bytes()), "{turn}");
        }
        receipts.push(add(&mut waiting, 100, "small"));
        for name in ["dear", "dearer than the small ones", "small"] {
            assert_eq!(take(&mut waiting), Digest::of(name.as_bytes()), "{name}");
        }
    }

    #[test]
    fn a_withdrawn_picture_leaves_its_place() {
        let mut waiting = Waiting::default();
        let kept = add(&mut waiting, 100, "kept");
        drop(add(&mut waiting, 100, "withdrawn"));
        assert_eq!((waiting.remove_withdrawn(), waiting.len()), (1, 1));
        assert!(waiting.find(Digest::of(b"kept")).is_some());
        drop(kept);
        assert_eq!((waiting.remove_withdrawn(), waiting.len()), (1, 0));
    }
}
