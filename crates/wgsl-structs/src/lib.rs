//! WGSL files in Rust: structs in the layout of theirs, generated from these files, and their texts.

mod generate;
mod wgsl;

use generate::Item;
use proc_macro::{Delimiter, Group, Ident, Literal, Punct, Spacing, Span, TokenStream, TokenTree};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Declares structs and constants of WGSL files in Rust:
///
/// ```ignore
/// wgsl_structs::wgsl! {
///     "../../shaders/lights.wgsl" {
///         pub struct Light as GpuLight;
///         pub const LIGHT_SPOT;
///     }
///     "../../shaders/scene.wgsl" {
///         use scene::Emitter;
///     }
///     pub fn layouts;
/// }
/// ```
///
/// Paths are relative to the folder of the package; a packed one has its own copy of what lies in `../../`. The structs are `repr(C)` and plain old data, with the members and
/// documentation of the WGSL; vectors and matrices are arrays. A struct that ends with an array sized at run time becomes
/// a struct of the members before it. A member's type is a scalar, a vector, a matrix, an array or a struct that is
/// listed before. Constants are literals. `use` checks the layout of a struct that Rust declares. The function returns the layouts of all structs, as
/// `shader_library::StructLayout`.
#[proc_macro]
pub fn wgsl(input: TokenStream) -> TokenStream {
    expand(input).unwrap_or_else(|(span, message)| {
        let message = TokenTree::Literal(Literal::string(&message));
        let mut tokens = [
            TokenTree::Ident(Ident::new("compile_error", span)),
            TokenTree::Punct(Punct::new('!', Spacing::Alone)),
            TokenTree::Group(Group::new(Delimiter::Brace, TokenStream::from(message))),
        ];
        tokens.iter_mut().for_each(|token| token.set_span(span));
        tokens.into_iter().collect()
    })
}

/// Returns the declarations that the input asks for.
///
/// # Errors
/// Where the input, or a file that it names, has another form: the place in the input, and a message.
fn expand(input: TokenStream) -> Result<TokenStream, (Span, String)> {
    let package = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    let (mut known, mut structs, mut code) = (BTreeMap::new(), Vec::new(), String::new());
    let mut tokens = input.into_iter().peekable();
    while let Some(token) = tokens.next_if(|token| matches!(token, TokenTree::Literal(_))) {
        let span = token.span();
        let file = token.to_string().trim_matches('"').to_owned();
        let path = in_package(Path::new(&package), &file);
        let source = std::fs::read_to_string(&path).map_err(|error| (span, format!("{file}: {error}")))?;
        code += &generate::dependency(&path);
        let Some(TokenTree::Group(group)) = tokens.next() else {
            return Err((
                span,
                "expected a list of structs and constants in braces after the file".to_owned(),
            ));
        };
        for (span, item) in items(group.stream())? {
            let at = |error: wgsl::Error| (span, format!("{file}:{}: {}", error.line, error.message));
            match item.keyword.as_str() {
                "struct" | "use" => {
                    let found = wgsl::read_struct(&source, &item.wgsl, &known).map_err(at)?;
                    code += &match item.keyword.as_str() {
                        "struct" => generate::structure(&file, &found, &item),
                        _ => generate::checks(&found, &item.rust),
                    };
                    known.insert(item.wgsl, found.as_type(&item.rust));
                    structs.push(found);
                }
                "const" => {
                    let found = wgsl::read_const(&source, &item.wgsl).map_err(at)?;
                    code += &generate::constant(&file, &found, &item);
                }
                _ => return Err((span, "expected `struct`, `use` or `const`".to_owned())),
            }
        }
    }
    for (span, item) in items(tokens.collect())? {
        match item.keyword.as_str() {
            "fn" => code += &generate::layouts(&structs, &item),
            _ => return Err((span, "expected a file, or a function for the layouts".to_owned())),
        }
    }
    code.parse().map_err(|error| (Span::call_site(), format!("{error}: {code}")))
}

/// Returns the place of a file of the tree: in the tree, or in a package that was packed from it.
fn in_package(package: &Path, file: &str) -> PathBuf {
    let in_tree = package.join(file);
    let packed = file.strip_prefix("../../").map(|file| package.join(file));
    packed.filter(|packed| packed.exists() && !in_tree.exists()).unwrap_or(in_tree)
}

/// Returns the WGSL files of the package, those of its tests apart, by path: `&'static [(&'static str, &'static str)]`, the paths from the
/// folder of the package with their texts. Takes nothing.
#[proc_macro]
pub fn files(_: TokenStream) -> TokenStream {
    let package = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let mut files = Vec::new();
    files_below(&package, &mut files);
    files.sort();
    let rows = files.iter().filter_map(|file| {
        let path = file.strip_prefix(&package).ok()?.to_string_lossy().replace('\\', "/");
        Some(format!("({path:?}, ::core::include_str!({file:?})),"))
    });
    format!("&[{}]", rows.collect::<String>()).parse().unwrap_or_default()
}

/// Collects the WGSL files below a folder that belong to its package and are no test's.
fn files_below(folder: &Path, files: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.flatten().map(|entry| entry.path()) {
        if path.is_dir() {
            let is_other =
                path.ends_with("tests") || path.ends_with("target") || path.join("Cargo.toml").exists();
            if !is_other {
                files_below(&path, files);
            }
        } else if path.extension().is_some_and(|extension| extension == "wgsl") {
            files.push(path);
        }
    }
}

/// Returns the declarations in a list such as `pub struct A; const B as C;`, with their places.
fn items(input: TokenStream) -> Result<Vec<(Span, Item)>, (Span, String)> {
    let mut items = Vec::new();
    let mut tokens = input.into_iter().peekable();
    while let Some(first) = tokens.peek() {
        let span = first.span();
        let words: Vec<String> =
            tokens.by_ref().map(|token| token.to_string()).take_while(|word| word != ";").collect();
        let visibility = words.iter().take_while(|word| *word == "pub" || word.starts_with('(')).count();
        let (visibility, words) = words.split_at(visibility);
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let (keyword, wgsl, rust) = match words[..] {
            [keyword, name] => (keyword, name, name.to_owned()),
            [keyword, wgsl, "as", rust] => (keyword, wgsl, rust.to_owned()),
            ["use", .., name] => ("use", name, words[1..].concat()),
            _ => {
                return Err((
                    span,
                    "expected `struct NAME;`, `struct NAME as OTHER;` or `const …`".to_owned(),
                ));
            }
        };
        let [keyword, wgsl] = [keyword, wgsl].map(str::to_owned);
        items.push((span, Item { visibility: visibility.concat(), keyword, wgsl, rust }));
    }
    Ok(items)
}
