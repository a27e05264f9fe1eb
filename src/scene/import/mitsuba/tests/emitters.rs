//! Emitters, by their numbers.

use super::Stage;
use crate::light::Emitter;
use crate::math::{Rgb, Vec3};

#[test]
fn emitters_are_read() {
    let stage = Stage::new();
    stage.exr("sky.exr", 4, 1.0);
    let d = stage.modern(
        "<emitter type='point'><transform name='to_world'><translate x='4'/></transform><rgb name='intensity' value='1 2 3'/></emitter>
         <emitter type='spot'><float name='cutoff_angle' value='40'/></emitter>
         <emitter type='directional'><vector name='direction' x='0' y='-2' z='0'/></emitter>
         <emitter type='constant'><float name='radiance' value='3'/></emitter>
         <emitter type='envmap'><string name='filename' value='sky.exr'/><float name='scale' value='2'/></emitter>
         <emitter type='projector'><float name='fov' value='45'/></emitter>",
    );
    assert_eq!(d.warnings, [""; 0]);
    let Emitter::Point {
        position,
        intensity,
    } = &d.emitters[0]
    else {
        panic!()
    };
    assert_eq!(
        (*position, *intensity),
        (Vec3::new(4.0, 0.0, 0.0), Rgb::new(1.0, 2.0, 3.0))
    );
    let Emitter::Spot { beam_degrees, .. } = &d.emitters[1] else {
        panic!()
    };
    assert_eq!(*beam_degrees, 30.0);
    let Emitter::Directional { direction, .. } = &d.emitters[2] else {
        panic!()
    };
    assert_eq!(*direction, Vec3::NEG_Y);
    let Emitter::Constant { radiance } = &d.emitters[3] else {
        panic!()
    };
    assert_eq!(*radiance, Rgb::splat(3.0));
    assert!(matches!(&d.emitters[4], Emitter::EnvironmentMap { scale, .. } if *scale == 2.0));
    assert!(
        matches!(&d.emitters[5], Emitter::Projector { fov_degrees, .. } if (*fov_degrees - 45.0).abs() < 1e-4)
    );
}

#[test]
fn skies_have_their_dialects_conventions() {
    let stage = Stage::new();
    let old = stage.classic("<emitter type='sunsky'><transform name='toWorld'><rotate y='1' angle='90'/></transform><vector name='sunDirection' x='1' y='1' z='0'/><float name='scale' value='5'/><float name='skyScale' value='2'/><float name='sunRadiusScale' value='4'/></emitter>");
    assert_eq!(old.warnings, [""; 0]);
    let Emitter::SunSky { settings, .. } = &old.emitters[0] else {
        panic!()
    };
    assert!(!settings.z_up && settings.sun && settings.sky);
    assert_eq!((settings.sun_scale, settings.sky_scale), (5.0, 2.0));
    assert!((settings.sun_radius_degrees - 4.0 * 0.2679).abs() < 1e-4);
    // World +x is the emitter's +z when the emitter is turned by 90 degrees around y.
    let expected = Vec3::new(0.0, 1.0, 1.0).normalize();
    assert!(
        (settings.sun_direction - expected).length() < 1e-6,
        "{}",
        settings.sun_direction
    );
    let new =
        stage.modern("<emitter type='sunsky'><float name='sun_aperture' value='2'/></emitter>");
    let Emitter::SunSky { settings, .. } = &new.emitters[0] else {
        panic!()
    };
    assert!(settings.z_up && (settings.sun_radius_degrees - 1.0).abs() < 1e-6);
    assert_eq!(settings.albedo, Rgb::splat(0.3));
    // Mitsuba 3 turns it alike whatever the scene's version says, and 0.x knows no such parameter.
    let mixed =
        stage.classic("<emitter type='sunsky'><float name='sun_aperture' value='2'/></emitter>");
    let Emitter::SunSky { settings: same, .. } = &mixed.emitters[0] else {
        panic!()
    };
    assert_eq!(same, settings);
}
