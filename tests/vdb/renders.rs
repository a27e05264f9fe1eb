//! Pictures of a grid from either kind of file.

use super::{Files, SIZE, densities};
use std::path::Path;
use std::process::Command;
use twintree::image;
use twintree::math::Vec3;
use twintree::medium::grids::Vol;

/// A box of fog under a lamp.
fn scene(file: &str, more: &str) -> String {
    format!(
        "<scene version='3.0.0'>
           <integrator type='volpath'><integer name='max_depth' value='8'/></integrator>
           <sensor type='perspective'>
             <transform name='to_world'>
               <lookat origin='4, 9, 20' target='1, 4, 7' up='0, 1, 0'/>
             </transform>
             <film type='hdrfilm'>
               <integer name='width' value='24'/><integer name='height' value='24'/>
             </film>
           </sensor>
           <emitter type='constant'><rgb name='radiance' value='0.5, 0.6, 0.7'/></emitter>
           <shape type='sphere'>
             <point name='center' x='1' y='12' z='7'/><float name='radius' value='1'/>
             <emitter type='area'><rgb name='radiance' value='20, 18, 15'/></emitter>
           </shape>
           <shape type='sphere'>
             <point name='center' x='1' y='4' z='7'/><float name='radius' value='6'/>
             <bsdf type='null'/>
             <medium name='interior' type='heterogeneous'>
               <volume name='sigma_t' type='gridvolume'>
                 <string name='filename' value='{file}'/>{more}
               </volume>
               <float name='scale' value='0.02'/>
             </medium>
           </shape>
         </scene>"
    )
}

fn render(folder: &Path, file: &str, more: &str) -> Vec<u32> {
    std::fs::write(folder.join("scene.xml"), scene(file, more)).unwrap();
    let done = Command::new(env!("CARGO_BIN_EXE_twintree"))
        .current_dir(folder)
        .args([
            "render",
            "scene.xml",
            "--spp",
            "16",
            "--guide",
            "none",
            "-o",
            "out.exr",
            "-q",
        ])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success() && said.is_empty(), "{said}");
    let picture = image::read(&folder.join("out.exr")).unwrap();
    picture.pixels.iter().map(|p| p.to_bits()).collect()
}

#[test]
fn the_same_grid_gives_the_same_bits_from_either_kind_of_file() {
    let files = Files::new();
    let folder = files.0.path();
    files.write("aligned");
    let low = Vec3::new(-0.75, 2.75, 5.25);
    let vol = Vol {
        resolution: SIZE,
        channels: 1,
        bbox: [low, low + 0.5 * Vec3::from_array(SIZE.map(|n| n as f32))],
        values: densities(),
    };
    vol.write(&folder.join("aligned.vol")).unwrap();
    let own = "<boolean name='use_grid_bbox' value='true'/>";
    let elsewhere = "<transform name='to_world'>
        <scale x='3' y='4' z='5'/><rotate y='1' angle='20'/><translate x='-1' y='2' z='5'/>
      </transform>";
    let both = format!("{own}{elsewhere}");
    let [a, b] = [own, elsewhere].map(|more| {
        let [by_vol, by_vdb] =
            ["aligned.vol", "aligned.vdb"].map(|file| render(folder, file, more));
        assert_eq!(by_vol, by_vdb, "{more}");
        by_vdb
    });
    assert_ne!(a, b);
    assert_ne!(render(folder, "aligned.vdb", &both), b);
}

#[test]
fn a_grid_of_vectors_is_an_albedo() {
    let files = Files::new();
    files.write("with-others");
    let place = "<transform name='to_world'><scale value='5'/></transform>";
    let albedo = format!(
        "{place}</volume><volume name='albedo' type='gridvolume'>
           <string name='filename' value='with-others.vdb'/>
           <string name='grid' value='color'/>{place}"
    );
    let grey = render(files.0.path(), "with-others.vdb", place);
    let coloured = render(files.0.path(), "with-others.vdb", &albedo);
    assert_ne!(grey, coloured);
}
