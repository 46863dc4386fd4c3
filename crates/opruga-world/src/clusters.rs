//! Bodies that are stepped through the frame together, and their stored contacts.

use crate::blueprint::Blueprint;
use crate::island::{FramePlan, Island};
use crate::meeting::Meeting;
use crate::path::Bounds;
use crate::scene_contact::{Cluster, Partition, SceneContact};
use opruga_collide::{Counts, Trouble};

/// All clusters of a scene.
#[derive(Debug)]
pub(crate) struct Clusters<const D: usize> {
    pub(crate) scene: SceneContact<D>,
    /// Islands that are stepped through the frame together, in the order of the first island of each group.
    pub(crate) groups: Vec<Group<D>>,
    /// The partition of the islands in this frame, and the partition for which the groups were made.
    partition: Partition,
    arranged_for: Option<Partition>,
    /// The contact work of meetings that no longer exist.
    counts: Counts,
    boxes: Vec<Bounds<D>>,
    order: Vec<u32>,
}

/// Islands with bodies that may touch, and their contacts. A body that touches nothing forms a group of one island.
#[derive(Debug)]
pub(crate) struct Group<const D: usize> {
    /// The islands, by their index in the world, ascending.
    pub(crate) islands: Vec<usize>,
    pub(crate) meetings: Vec<Meeting<D>>,
    pub(crate) progress: Progress,
}

/// The progress of a group through the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Progress {
    /// Not stepped yet.
    Waiting,
    /// Stepped; its islands hold the outcome.
    Done,
    /// Stopped by an error at a time [s]; the error names bodies by their numbers in the scene.
    Stuck(Trouble, f64),
}

impl<const D: usize> Clusters<D> {
    pub(crate) fn of(scene: SceneContact<D>) -> Clusters<D> {
        Clusters {
            scene,
            groups: Vec::new(),
            partition: Partition::default(),
            arranged_for: None,
            counts: Counts::default(),
            boxes: Vec::new(),
            order: Vec::new(),
        }
    }

    /// The contacts of all clusters.
    pub(crate) fn meetings(&self) -> impl Iterator<Item = &Meeting<D>> {
        self.groups.iter().flat_map(|group| &group.meetings)
    }

    pub(crate) fn meetings_mut(&mut self) -> impl Iterator<Item = &mut Meeting<D>> {
        self.groups.iter_mut().flat_map(|group| &mut group.meetings)
    }

    /// The contact work since the bodies were grouped.
    pub(crate) fn counts(&self) -> Counts {
        self.meetings().fold(self.counts, |sum, meeting| sum.and(&meeting.touching.counts))
    }

    /// Turns the report of contacts on or off.
    pub(crate) fn report(&mut self, report: bool) {
        self.meetings_mut().for_each(|meeting| meeting.touching.report = report);
    }

    /// Begins a frame. Bodies that would come close at their present velocities are grouped.
    pub(crate) fn begin(&mut self, blueprint: &Blueprint<D>, islands: &[Island<D>], plan: &FramePlan<'_, D>) {
        let Clusters { scene, partition, boxes, order, .. } = self;
        boxes.clear();
        boxes.resize(scene.bodies.len(), [[0.0; D]; 2]);
        for island in islands {
            island.swept_by_bodies(plan, |lane, swept| {
                if let Ok(number) = scene.bodies.binary_search(&island.bodies[lane]) {
                    boxes[number] = swept;
                }
            });
        }
        partition.begin(scene.bodies.len());
        partition.join(scene, plan, boxes, order);
        self.arrange(blueprint, islands);
        self.groups.iter_mut().for_each(|group| group.progress = Progress::Waiting);
    }

    /// Checks where the bodies have moved. If bodies have come close to bodies of other groups, merges these groups, which must then be stepped
    /// through the frame again. Returns whether there are any groups to step.
    pub(crate) fn merge(&mut self, blueprint: &Blueprint<D>, islands: &[Island<D>], plan: &FramePlan<'_, D>) -> bool {
        let Clusters { scene, partition, boxes, order, .. } = self;
        for (number, (island, lane)) in scene.seats.iter().enumerate() {
            boxes[number] = islands[*island].path.of(islands[*island].system.layout, *lane);
        }
        if !partition.join(scene, plan, boxes, order) {
            return false;
        }
        self.arrange(blueprint, islands);
        self.groups.iter().any(|group| group.progress == Progress::Waiting)
    }

    /// Makes the groups of the clusters. Unchanged groups keep their contacts and their progress.
    fn arrange(&mut self, blueprint: &Blueprint<D>, islands: &[Island<D>]) {
        if self.arranged_for.as_ref() == Some(&self.partition) {
            return;
        }
        let mut clusters = self.partition.clusters(&self.scene);
        let groups = groups_of(&self.scene, &clusters, islands.len());
        let mut old: Vec<Option<Group<D>>> = std::mem::take(&mut self.groups).into_iter().map(Some).collect();
        let mut old_of = vec![usize::MAX; islands.len()];
        for (number, group) in old.iter().flatten().enumerate() {
            group.islands.iter().for_each(|island| old_of[*island] = number);
        }
        for (islands_of, numbers) in groups {
            let known = old.get_mut(old_of[islands_of[0]]).filter(|group| {
                group.as_ref().is_some_and(|group| {
                    let same = |(meeting, number): (&Meeting<D>, &usize)| meeting.cluster == clusters[*number];
                    group.islands == islands_of
                        && group.meetings.len() == numbers.len()
                        && group.meetings.iter().zip(&numbers).all(same)
                })
            });
            if let Some(group) = known.and_then(Option::take) {
                self.groups.push(group);
                continue;
            }
            let mut make = |number: &usize| {
                let cluster = std::mem::take(&mut clusters[*number]);
                Meeting::of(blueprint, &self.scene, islands, &islands_of, cluster)
            };
            let meetings = numbers.iter().map(&mut make).collect();
            self.groups.push(Group { islands: islands_of, meetings, progress: Progress::Waiting });
        }
        for meeting in old.iter().flatten().flat_map(|group| &group.meetings) {
            self.counts = self.counts.and(&meeting.touching.counts);
        }
        self.arranged_for = Some(self.partition.clone());
    }
}

/// The islands that clusters join, together with these clusters, in the order of the first islands.
fn groups_of<const D: usize>(
    scene: &SceneContact<D>,
    clusters: &[Cluster],
    islands: usize,
) -> Vec<(Vec<usize>, Vec<usize>)> {
    let mut parent: Vec<usize> = (0..islands).collect();
    fn root(parent: &[usize], mut island: usize) -> usize {
        while parent[island] != island {
            island = parent[island];
        }
        island
    }
    let island_of = |body: &u32| scene.seats[*body as usize].0;
    for cluster in clusters {
        for body in &cluster.bodies[1..] {
            let (a, b) = (root(&parent, island_of(&cluster.bodies[0])), root(&parent, island_of(body)));
            let (low, high) = if a < b { (a, b) } else { (b, a) };
            parent[high] = low;
        }
    }
    let mut out: Vec<(Vec<usize>, Vec<usize>)> = Vec::new();
    let mut number = vec![usize::MAX; islands];
    for island in 0..islands {
        parent[island] = parent[parent[island]];
        if parent[island] == island {
            number[island] = out.len();
            out.push(Default::default());
        }
        out[number[parent[island]]].0.push(island);
    }
    for (k, cluster) in clusters.iter().enumerate() {
        out[number[parent[island_of(&cluster.bodies[0])]]].1.push(k);
    }
    out
}
