//! Results are the same to the bit for all tiles, vector instructions and layouts.

use super::Suite;
use super::case::{Answer, Body, Case, by_node, difference, irregular, regular, unequal_bits};
use super::random::Random;
use crate::potential::Potential;
use crate::state::{Columns, Layout, Parameter};
use crate::tile::TILE;
use opruga_math::{Lane, Simd, WIDTH, sum_in_fixed_order};

impl<const D: usize> Suite<'_, D> {
    /// Checks that results do not depend on tiles, vector instructions and layouts, to the bit.
    pub(super) fn same_bits(
        &self,
        random: &mut Random,
        potential: &dyn Potential<D>,
        add: &mut dyn FnMut(&'static str, f64, f64),
    ) -> Answer<()> {
        let best = Simd::best();
        let nodes = self.mesh.positions.len();
        let all = self.build(None)?;
        let bodies: Vec<&Body<D>> = self.bodies.iter().collect();
        let mut alone = self.case(potential, &self.bodies[0]);
        let mut eight = Case::new(&*all, Layout::Batch, &bodies, self.options.time);

        let (mut tiles, mut lanes) = (0.0, 0.0);
        let gravity: [f64; D] = random.vector();
        for case in [&mut alone, &mut eight] {
            let index_count = case.index_count();
            let stride = case.layout.stride();
            let columns = |c: &Columns<D>| (0..nodes * stride).map(|p| c.at(p)).collect::<Vec<_>>();
            let (whole, power) = case.forces(best, &regular(index_count, index_count), None)?;
            let whole = columns(&whole);
            let mut cuts =
                vec![regular(index_count, TILE), regular(index_count, WIDTH), regular(index_count, 3 * WIDTH)];
            cuts.extend((0..4).map(|_| irregular(index_count, random)));
            for cut in &cuts {
                tiles += unequal_bits(&columns(&case.forces(best, cut, None)?.0), &whole);
            }
            // If the forces begin with the weight, the bits must not depend on whether the model adds the weight or it was
            // added before.
            let mass = Parameter::from_items(case.layout, nodes, |n, l| self.bodies[l].mass[n]);
            if case.potential.properties().begins_tiles {
                for cut in &cuts {
                    let before = case.forces(best, cut, Some((&mass, gravity, false)))?.0;
                    let fused = case.forces(best, cut, Some((&mass, gravity, true)))?.0;
                    tiles += unequal_bits(&columns(&before), &columns(&fused));
                }
            }
            let energy = case.energy(best)?;
            for simd in Simd::available() {
                let (force, other) = case.forces(simd, &regular(index_count, index_count), None)?;
                lanes += unequal_bits(&columns(&force), &whole);
                lanes += unequal_bits(&[other], &[power]) + unequal_bits(&[case.energy(simd)?], &[energy]);
            }
        }
        add("tiles", tiles, 0.0);
        add("lanes", lanes, 0.0);

        // Compare eight bodies side by side with each of them by itself.
        let mut batch = 0.0;
        let mut powers = 0.0;
        let (together, power) = eight.forces(best, &regular(eight.index_count(), TILE), None)?;
        let energies = eight.energy(best)?;
        for l in 0..WIDTH {
            let own = self.build(Some(l))?;
            let mut case = self.case(&*own, &self.bodies[l]);
            let (force, own_power) = case.plain(best)?;
            batch += unequal_bits(&by_node(&together, Layout::Batch, nodes, l), &force);
            let energy = sum_in_fixed_order(&case.energy(best)?);
            batch += unequal_bits(&[[energies[l]]], &[[energy]]);
            powers = Lane::larger(difference(&[power[l]], &[own_power], 0.0), powers);
        }
        add("batch", batch, 0.0);
        // Power is summed in another order.
        add("batch power", powers, 1e-11);
        Ok(())
    }
}
