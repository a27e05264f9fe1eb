//! Where the sun stands, from date and place.
//!
//! The algorithm of Blanco-Muriel, Alarcon-Padilla, Lopez-Moratalla and Lara-Coira, "Computing the
//! Solar Vector", Solar Energy 70(5), 2001: good to half an arc minute between 1999 and 2015, and
//! to much less than the sun's diameter for centuries around.

use crate::math::DVec3;
use std::f64::consts::TAU;

/// A moment somewhere on earth.
#[derive(Clone, Copy, Debug)]
pub(super) struct DateAndPlace {
    pub year: i64,
    pub month: i64,
    pub day: i64,
    /// Local time.
    pub hour: f64,
    pub minute: f64,
    pub second: f64,
    /// Degrees north.
    pub latitude: f64,
    /// Degrees east.
    pub longitude: f64,
    /// Local time minus universal time, hours.
    pub timezone: f64,
}

impl Default for DateAndPlace {
    /// Mitsuba's: Tokyo on 10 July 2010, 3 in the afternoon.
    fn default() -> Self {
        Self {
            year: 2010,
            month: 7,
            day: 10,
            hour: 15.0,
            minute: 0.0,
            second: 0.0,
            latitude: 35.6894,
            longitude: 139.6917,
            timezone: 9.0,
        }
    }
}

/// Position of the sun in the sky.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sun {
    /// Angle from straight up, radians.
    pub zenith: f64,
    /// Angle from north over east, radians.
    pub azimuth: f64,
}

impl Sun {
    /// Direction in Mitsuba 0.x's coordinates: +y is up, +x is east, -z is north.
    pub fn y_up(self) -> DVec3 {
        let (sin, cos) = self.zenith.sin_cos();
        DVec3::new(self.azimuth.sin() * sin, cos, -self.azimuth.cos() * sin)
    }

    /// Direction in Mitsuba 3's coordinates: +z is up, -x is north, -y is east.
    pub fn z_up(self) -> DVec3 {
        let (sin, cos) = self.zenith.sin_cos();
        DVec3::new(-self.azimuth.cos() * sin, -self.azimuth.sin() * sin, cos)
    }
}

/// Days from noon of 1 January 2000 (universal time), and the hour of the day.
fn elapsed_days(when: &DateAndPlace) -> (f64, f64) {
    let hour = when.hour - when.timezone + (when.minute + when.second / 60.0) / 60.0;
    // Julian day number after the Astronomical Almanac; integer divisions round towards zero.
    let january = (when.month - 14) / 12;
    let day_number = (1461 * (when.year + 4800 + january)) / 4
        + (367 * (when.month - 2 - 12 * january)) / 12
        - (3 * ((when.year + 4900 + january) / 100)) / 4
        + when.day
        - 32075;
    (day_number as f64 - 0.5 + hour / 24.0 - 2_451_545.0, hour)
}

/// The sun's position.
pub(super) fn sun(when: &DateAndPlace) -> Sun {
    let (days, hour) = elapsed_days(when);
    // Ecliptic coordinates.
    let omega = 2.1429 - 0.001_039_459_4 * days;
    let mean_longitude = 4.895_063_0 + 0.017_202_791_698 * days;
    let anomaly = 6.240_060_0 + 0.017_201_969_9 * days;
    let longitude =
        mean_longitude + 0.033_416_07 * anomaly.sin() + 0.000_348_94 * (2.0 * anomaly).sin()
            - 0.000_113_4
            - 0.000_020_3 * omega.sin();
    let obliquity = 0.409_092_8 - 6.214_0e-9 * days + 0.000_039_6 * omega.cos();
    // Celestial coordinates.
    let right_ascension = (obliquity.cos() * longitude.sin())
        .atan2(longitude.cos())
        .rem_euclid(TAU);
    let declination = (obliquity.sin() * longitude.sin()).asin();
    // Local coordinates.
    let greenwich = 6.697_424_324_2 + 0.065_709_828_3 * days + hour;
    let local = (greenwich * 15.0 + when.longitude).to_radians();
    let hour_angle = local - right_ascension;
    let (sin_latitude, cos_latitude) = when.latitude.to_radians().sin_cos();
    let zenith = (cos_latitude * hour_angle.cos() * declination.cos()
        + declination.sin() * sin_latitude)
        .clamp(-1.0, 1.0)
        .acos();
    let azimuth = (-hour_angle.sin())
        .atan2(declination.tan() * cos_latitude - sin_latitude * hour_angle.cos())
        .rem_euclid(TAU);
    // The observer stands on the earth's surface, not at its centre: mean radius over distance, km.
    let parallax = 6371.01 / 149_597_890.0 * zenith.sin();
    Sun {
        zenith: zenith + parallax,
        azimuth,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Means of 3000 directions that Mitsuba 3.9.1's `sunsky` draws towards its sun (of 1 degree).
    #[test]
    fn agrees_with_mitsuba_3() {
        let morning = DateAndPlace {
            hour: 9.0,
            ..DateAndPlace::default()
        };
        for (when, expected) in [
            (morning, [0.0957, -0.6147, 0.7829]),
            (DateAndPlace::default(), [0.0514, 0.6918, 0.7203]),
        ] {
            let error = sun(&when).z_up() - DVec3::from_array(expected);
            assert!(error.length() < 1e-3, "{error}");
        }
    }

    /// At the March equinox the sun culminates at the complement of the latitude, in the south.
    #[test]
    fn equinox_noon_is_in_the_south_at_the_complement_of_the_latitude() {
        let noon = DateAndPlace {
            year: 2010,
            month: 3,
            day: 20,
            hour: 17.5,
            minute: 7.0,
            latitude: 48.0,
            longitude: 0.0,
            timezone: 5.5,
            ..DateAndPlace::default()
        };
        let sun = sun(&noon);
        assert!((sun.zenith.to_degrees() - 48.0).abs() < 0.3, "{sun:?}");
        assert!((sun.azimuth.to_degrees() - 180.0).abs() < 1.0, "{sun:?}");
        assert!(sun.y_up().z > 0.7, "south is +z");
    }
}
