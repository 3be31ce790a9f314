//! `afmsweep modes`.

use super::{SceneArgs, Voice};

pub fn main(args: &SceneArgs, _voice: Voice) -> anyhow::Result<()> {
    anyhow::bail!("{}: not built yet ({})", args.scene.display(), args.json)
}
