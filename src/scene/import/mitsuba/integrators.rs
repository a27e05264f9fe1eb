//! Integrators: what they say about paths is kept; the path tracer stands for all of them.

use super::importer::Importer;
use super::params::Params;
use crate::scene::import::ImportError;

/// Reads an integrator's settings.
pub(super) fn integrator<'a>(
    importer: &mut Importer<'a>,
    p: &Params<'a>,
    index: usize,
) -> Result<(), ImportError> {
    importer.step_into(index)?;
    let plugin = p.plugin();
    let render = &mut importer.render;
    render.hide_emitters = p.boolean("hide_emitters", render.hide_emitters);
    render.strict_normals = p.boolean("strict_normals", render.strict_normals);
    if plugin == "direct" {
        // Emission, and light that arrives straight at the first surface. How many samples it
        // shoots at lights and along materials is not a question here.
        render.max_depth = Some(2);
        p.ignore(&["shading_samples", "emitter_samples", "bsdf_samples"]);
    }
    if let Some(depth) = p.integer("max_depth") {
        render.max_depth = match depth {
            -1 => None,
            _ => Some(p.count("max_depth", u32::MAX, 0)),
        };
    }
    render.rr_depth = p.count("rr_depth", render.rr_depth, 1);
    let nested = p.children("integrator");
    for (_, inner) in &nested {
        let params = Params::new(importer.document, *inner);
        integrator(importer, &params, *inner)?;
    }
    match plugin {
        "path" | "direct" | "volpath" | "volpathmis" => importer.done(p),
        "guided_path" | "volpath_simple" => {
            replaced(importer, p, "is rendered by this program's own path tracer");
        }
        _ if !nested.is_empty() => {
            replaced(importer, p, "is left out; the integrator inside it is used");
        }
        _ => replaced(importer, p, "is not known here; path tracing is used"),
    }
    Ok(())
}

/// One warning for an integrator that something else stands for, with the parameters that fall
/// away.
fn replaced(importer: &mut Importer, p: &Params, what: &str) {
    let place = importer.document.location(p.at());
    let lost = p.unused_names();
    let lost: Vec<&str> = lost.into_iter().filter(|n| !n.is_empty()).collect();
    let rest = if lost.is_empty() {
        String::new()
    } else {
        format!("; ignored: {}", lost.join(", "))
    };
    let plugin = p.plugin();
    importer
        .warnings
        .tell(format!("{place}: integrator \"{plugin}\" {what}{rest}"));
}
