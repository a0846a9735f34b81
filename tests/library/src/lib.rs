//! Looks at what the build script made with ltcforge's library.

include!(concat!(env!("OUT_DIR"), "/facts.rs"));

/// The table, as a program would embed it.
pub const TABLE: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/table.safetensors"));

/// The shader that reads it.
pub const SHADER: &str = include_str!(concat!(env!("OUT_DIR"), "/ltc.wgsl"));

#[cfg(test)]
mod tests {
    use super::*;

    /// The digests that `tests/cli/same_bytes.rs` pins for the command, whatever this was compiled for.
    const PINNED_DIGEST: &str = "sha256:2c3d0be191fa318bae02c01a19581ccfd5ffe169f39cf14adc6ab35065d221d3";
    const PINNED_GAUSSIANS: [&str; 2] = [
        "sha256:3f719fc926b56fa7c427aa842ea95aee574242605683c00d634ed8b246fbf74b",
        "sha256:82ca1d11e86d7361f151d7fed723c6f913bb8d1e8405bb61b556b9c5c6a7dc37",
    ];

    #[test]
    fn the_bytes_are_pinned() {
        assert_eq!(DIGEST, PINNED_DIGEST);
        assert_eq!(GAUSSIANS, PINNED_GAUSSIANS);
        assert!(SAME);
        assert!(TABLE.len() > 108 * 4 * 12, "{}", TABLE.len());
    }

    #[test]
    fn a_cached_table_is_not_fitted_again() {
        assert!(HIT);
    }

    #[test]
    fn a_fit_reports_progress_and_stops_when_told_to() {
        assert_eq!(ENTRIES, 108);
        assert!(STOPPED);
    }

    #[test]
    fn a_table_is_looked_up_measured_and_read_by_a_shader() {
        assert!(DETERMINANT > 0.0, "{DETERMINANT}");
        assert!(ERROR > 0.0 && ERROR < 1.0, "{ERROR}");
        assert!(SHADER.contains("fn ltc_lookup(") && SHADER.contains("fn ltc_restore("));
    }

    #[test]
    fn an_invalid_recipe_lists_every_fault() {
        assert!(FAULTS.contains("/fit/samples") && FAULTS.contains("/resolution/beta"), "{FAULTS}");
    }
}
