//! What can go wrong while a tree is built.

/// Why a ray tracer could not be built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AccelError {
    /// The ray tracer could not be started.
    #[error("the ray tracer could not be started: {0}")]
    Device(String),
    /// The tree does not fit into memory.
    #[error(
        "out of memory while {doing}, with {} MiB in the tree: ask for a compact tree, \
         or give less geometry or more memory", bytes >> 20
    )]
    OutOfMemory {
        /// What was being built.
        doing: String,
        /// Bytes the tree held by then.
        bytes: usize,
    },
    /// The ray tracer refused.
    #[error("error while {doing}: {reason}")]
    Build {
        /// What was being built.
        doing: String,
        /// Why it failed, in words.
        reason: String,
    },
    /// An instance names a group that does not exist.
    #[error("instance {instance} names group {group}, but there are {groups} groups")]
    MissingGroup {
        /// Index of the instance.
        instance: usize,
        /// The group it names.
        group: u32,
        /// How many there are.
        groups: usize,
    },
    /// An instance cannot be placed.
    #[error(
        "the transformation of instance {instance} cannot be inverted: it has a scale of 0 \
         (or nearly), or a value that is not finite"
    )]
    SingularInstance {
        /// Index of the instance.
        instance: usize,
    },
    /// More geometry than 32 bits can number.
    #[error("{what} number {count}, beyond the 4 294 967 294 that can be addressed")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// How much there is.
        count: usize,
    },
    /// The ray tracer asked for was not compiled in.
    #[error("{0} is not part of this build: compile with the feature \"embree\", or choose obvhs")]
    NotCompiled(&'static str),
}
