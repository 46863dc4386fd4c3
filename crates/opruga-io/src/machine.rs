//! The memory that the machine gives to this program.

use std::fs::read_to_string;
use std::path::Path;

/// The fraction of the memory that the bodies of a scene may take. The program, its threads and the scene reader need the rest.
const PART: f64 = 0.8;

/// The memory that bodies may take [bytes], if the machine reports how much it has. The limits are the physical memory, the limits of the process
/// groups that contain this process (cgroups, as in containers), and the limit of the address space; the smallest of these counts.
pub(crate) fn memory_bytes() -> Option<u64> {
    let physical = read_to_string("/proc/meminfo").ok().and_then(|text| physical(&text));
    let group = read_to_string("/proc/self/cgroup").ok().and_then(|text| group(&text, Path::new("/sys/fs/cgroup")));
    let own = read_to_string("/proc/self/limits").ok().and_then(|text| address_space(&text));
    let least = [physical, group, own].into_iter().flatten().min()?;
    Some((PART * least as f64) as u64)
}

/// `MemTotal` of `/proc/meminfo`.
fn physical(text: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

/// The soft limits in `/proc/self/limits` beyond which memory cannot be allocated.
fn address_space(text: &str) -> Option<u64> {
    let soft = |name: &str| {
        let line = text.lines().find_map(|line| line.strip_prefix(name))?;
        line.split_whitespace().next()?.parse().ok()
    };
    ["Max address space", "Max data size"].into_iter().filter_map(soft).min()
}

/// The lowest limit of the control groups in `/proc/self/cgroup` and of their parents, in version 2 or version 1 of control groups.
fn group(text: &str, root: &Path) -> Option<u64> {
    let mut least: Option<u64> = None;
    for line in text.lines() {
        let mut parts = line.splitn(3, ':');
        let (_, controllers, path) = (parts.next()?, parts.next()?, parts.next()?);
        let (mount, file) = match controllers {
            "" => (root.to_path_buf(), "memory.max"),
            "memory" => (root.join("memory"), "memory.limit_in_bytes"),
            _ => continue,
        };
        let inner = mount.join(path.trim_start_matches('/'));
        // A container sees its own group as the root, whatever its name outside is.
        for folder in inner.ancestors().take_while(|folder| folder.starts_with(&mount)) {
            let limit = read_to_string(folder.join(file)).ok().and_then(|text| text.trim().parse().ok());
            least = [least, limit].into_iter().flatten().min();
        }
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_of_what_the_system_says_is_the_limit() {
        assert_eq!(physical("MemTotal:       24689304 kB\nMemFree: 1 kB\n"), Some(24_689_304 * 1024));
        assert_eq!(physical("nothing"), None);
        let limits = "Limit                     Soft Limit           Hard Limit           Units\n\
                      Max data size             unlimited            unlimited            bytes\n\
                      Max address space         512000000            unlimited            bytes\n";
        assert_eq!(address_space(limits), Some(512_000_000));
        assert_eq!(address_space(&limits.replace("512000000", "unlimited")), None);
    }

    #[test]
    fn the_tightest_group_around_the_program_counts_in_both_versions() {
        let root = tempfile::tempdir().expect("a folder");
        let put = |path: &str, text: &str| {
            let path = root.path().join(path);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            std::fs::write(path, text).expect("a file");
        };
        put("outer/memory.max", "4000\n");
        put("outer/inner/memory.max", "max\n");
        assert_eq!(group("0::/outer/inner\n", root.path()), Some(4000));
        put("memory/box/memory.limit_in_bytes", "3000\n");
        assert_eq!(group("5:memory:/box\n4:cpu:/box\n0::/outer/inner\n", root.path()), Some(3000));
        // Inside a container the path does not exist, and the root has the limit.
        put("memory/memory.limit_in_bytes", "2000\n");
        assert_eq!(group("5:memory:/elsewhere\n", root.path()), Some(2000));
        assert_eq!(group("0::/elsewhere\n", root.path()), None);
    }
}
