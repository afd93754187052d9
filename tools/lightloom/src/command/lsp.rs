//! `lightloom lsp`: the language server, for editors.

use super::check;
use crate::context::Context;
use anyhow::{Result, bail};
use language_server::{Check, Language, begin, check_wgsl, serve};
use lsp_server::Connection;
use renderer::Assets;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Answer an editor over standard input and output, by the Language Server Protocol.
#[derive(clap::Args)]
#[command(after_help = "docs/editor.md says how editors start it.")]
pub(crate) struct Args {
    /// The scene whose traits decide switches and variants
    #[arg(long, default_value = "cornell-box")]
    scene: String,
    /// Taken for editors that say how they speak; there is no other way
    #[arg(long, hide = true)]
    stdio: bool,
}

/// Answers; `has_root` says whether the root of `context` was given on the command line.
pub(crate) fn run(has_root: bool, context: &Context, args: &Args) -> Result<()> {
    let (connection, threads) = Connection::stdio();
    let (params, folders) = begin(&connection)?;
    // As for a command that is run in the folder that the editor has opened.
    let folder = folders.first().filter(|folder| std::env::set_current_dir(folder).is_ok());
    let of_folder = folder.filter(|_| !has_root).and_then(|folder| Assets::find_root(folder));
    let root = of_folder.or_else(|| context.catalog.assets().root().map(Into::into));
    let context = Context::new(Vec::new(), root, false, context.phases.clone());
    let (catalog, scene) = (Arc::clone(&context.catalog), args.scene.clone());
    let traits = Mutex::new(BTreeMap::new());
    let check: Arc<Check> = Arc::new(move |name, language| match language {
        Language::Ron(Some(sort)) => {
            let mut traits = traits.lock().unwrap_or_else(PoisonError::into_inner);
            check::diagnostics(&context, (sort, name), &scene, &mut traits)
        }
        Language::Ron(None) => Vec::new(),
        Language::Wgsl => check_wgsl(&context.catalog, name),
    });
    let asked = serve(&connection, (&params, folders), catalog, check)?;
    // Its threads end where nothing can be sent any more.
    drop(connection);
    threads.join()?;
    if !asked {
        bail!("the editor has ended, and has not asked the server to");
    }
    Ok(())
}
