#![allow(missing_docs)]
use std::collections::BTreeMap;
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Cells { pub triangles: Vec<[u32;3]>, pub quadrilaterals: Vec<[u32;4]>, pub tetrahedra: Vec<[u32;4]>, pub hexahedra: Vec<[u32;8]> }
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Mesh<const D: usize> { pub positions: Vec<[f64; D]>, pub facets: Vec<[u32; D]>, pub wires: Vec<[u32;2]>, pub sheets: Vec<[u32;3]>, pub cells: Cells, pub groups: BTreeMap<String, Vec<u32>> }
#[derive(Clone,Copy,Debug,PartialEq)] pub enum EdgeSet{Boundary,All,AllWithShear}
#[derive(Debug, Clone, PartialEq)] pub struct MeshError; impl std::fmt::Display for MeshError{fn fmt(&self,_:&mut std::fmt::Formatter<'_>)->std::fmt::Result{Ok(())}}
impl<const D: usize> Mesh<D>{
 pub fn edges(&self,_:EdgeSet)->Vec<[u32;2]>{ let mut e=std::collections::BTreeSet::new(); for f in &self.facets{ for k in 0..D{ let (a,b)=(f[k],f[(k+1)%D]); if D==2&&k==1{continue;} e.insert((a.max(b)-a.min(b),a.min(b),a.max(b))); } } e.into_iter().map(|(_,a,b)|[a,b]).collect() }
 pub fn edge_areas(&self,e:&[[u32;2]])->Vec<f64>{vec![0.0;e.len()]}
 pub fn chambers(&self)->Result<Vec<Vec<u32>>,MeshError>{Ok(vec![(0..self.facets.len() as u32).collect()])}
 pub fn lumped_shares(&self)->Vec<f64>{vec![1.0/self.positions.len() as f64; self.positions.len()]}
 pub fn measure_dimension(&self)->usize{D-1}
}
pub fn signed_volume<const D:usize>(f:&[[u32;D]],x:&[[f64;D]])->f64{ let mut v=0.0; for t in f { let a=x[t[0] as usize]; let b=x[t[1] as usize]; if D==2 { v+=0.5*(a[0]*b[1]-a[1]*b[0]); } else { let c=x[t[2] as usize]; v+=(a[0]*(b[1]*c[2]-b[2]*c[1])+a[1]*(b[2]*c[0]-b[0]*c[2])+a[2]*(b[0]*c[1]-b[1]*c[0]))/6.0; } } v}
pub fn node_rings(t:&[[u32;3]],n:usize)->Result<Vec<Vec<u32>>,MeshError>{ let mut nx=vec![BTreeMap::new();n]; for f in t{ for k in 0..3{ nx[f[k] as usize].insert(f[(k+1)%3],f[(k+2)%3]); } } Ok(nx.iter().map(|m|{ let mut o=vec![]; if let Some((&s,_))=m.iter().next(){ let mut c=s; loop{ o.push(c); c=m[&c]; if c==s{break} } } o}).collect()) }
