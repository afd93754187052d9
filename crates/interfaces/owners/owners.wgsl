// The interface Owners.

/// What has no owner.
const NO_OWNER: u32 = 0xffffffffu;
