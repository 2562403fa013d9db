//! The state diagrams in a page: the fences of Markdown that begin with ```` ```mermaid ````.

use lapwing_diag::{Code, Diagnostic};

use crate::Report;
use crate::mermaid;
use crate::sheet::Sheet;

/// Reads all state diagrams of a page. Other drawings of Mermaid are passed over.
pub(crate) fn read(text: &str, name: &str, sheet: &mut Sheet, report: &mut Report) {
    let diagrams = diagrams(text);
    if diagrams.is_empty() {
        let message = "there is no state diagram in this page";
        let help = "a diagram stands between ```` ```mermaid ```` and ```` ``` ````, and begins with `stateDiagram-v2`";
        report.push(Diagnostic::new(Code::ImportSyntax, report.span(0, 0), message).help(help));
    }
    for (number, (start, diagram)) in diagrams.iter().enumerate() {
        let name = if diagrams.len() > 1 { format!("{name}_{}", number + 1) } else { name.to_owned() };
        mermaid::read(diagram, *start, &name, sheet, report);
    }
}

/// The state diagrams, each with the byte at which it begins.
fn diagrams(text: &str) -> Vec<(usize, &str)> {
    let mut found = Vec::new();
    let mut open: Option<(usize, &str)> = None;
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let (start, trimmed) = (at, line.trim());
        at += line.len();
        match open {
            None => {
                let fence = trimmed.trim_start_matches(['`', '~']);
                let signs = trimmed.get(..trimmed.len() - fence.len()).unwrap_or("");
                if signs.len() >= 3 {
                    // Another fence is passed over to its own end.
                    open = Some((if is_mermaid(fence) { at } else { usize::MAX }, signs));
                }
            }
            Some((begin, signs)) if trimmed.starts_with(signs) && trimmed.trim_start_matches(['`', '~']).is_empty() => {
                let inside = text.get(begin..start).unwrap_or("");
                if mermaid::is_state_diagram(inside) {
                    found.push((begin, inside));
                }
                open = None;
            }
            Some(_) => {}
        }
    }
    found
}

/// Whether what follows the signs of a fence says that it holds a drawing of Mermaid: `mermaid`, perhaps with attributes, or MyST's `{mermaid}`.
fn is_mermaid(info: &str) -> bool {
    let word = info.trim().split([' ', '\t']).next().unwrap_or("");
    matches!(word, "mermaid" | "{mermaid}" | "{.mermaid}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_state_diagrams_are_found() {
        let page = "# x\n```mermaid\nflowchart TD\n```\n````md\n```mermaid\nstateDiagram\n```\n````\n```mermaid\n%% y\n\nstateDiagram-v2\na\n```\n\
                    ~~~mermaid\n---\ntitle: z\n---\nstateDiagram\n~~~\n```{mermaid} x\n%%{init: {\n  \"theme\": 1\n}}%%\nstateDiagram-v2\n```\n\
                    ```mermaid\nstateDiagram-v2\n";
        let found: Vec<&str> = diagrams(page)
            .iter()
            .map(|(start, d)| {
                assert_eq!(&page[*start..*start + d.len()], *d);
                *d
            })
            .collect();
        let styled = "%%{init: {\n  \"theme\": 1\n}}%%\nstateDiagram-v2\n";
        assert_eq!(found, ["%% y\n\nstateDiagram-v2\na\n", "---\ntitle: z\n---\nstateDiagram\n", styled]);
    }
}
