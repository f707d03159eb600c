//! The classifier, as far as LPIPS uses it.

use std::collections::HashMap;

use super::Lpips;
use super::layers::{Convolution, Tensor};

/// One step through a network.
#[derive(Clone, Debug)]
pub(super) enum Layer {
    Convolution(Convolution),
    /// 3 x 3 maxima at every second place.
    Pool,
    /// What comes out here is compared.
    Tap,
}

/// Weights by name: shape and values.
pub(super) type Tensors = HashMap<String, (Vec<usize>, Vec<f32>)>;

/// A network from weights named as torchvision names them, or what is wrong with them.
pub(super) fn build(mut tensors: Tensors) -> Result<Lpips, String> {
    let mut layers = Vec::new();
    let mut convolution = |name: &str, size: usize, stride: usize, padding: usize| {
        let mut take = |part: &str| {
            let name = format!("{name}.{part}");
            tensors.remove(&name).ok_or_else(|| format!("{name} is missing"))
        };
        let (shape, kernel) = take("weight")?;
        let (_, bias) = take("bias")?;
        match shape[..] {
            [outputs, inputs, height, width]
                if (height, width) == (size, size)
                    && bias.len() == outputs
                    && kernel.len() == outputs * inputs * size * size =>
            {
                Ok(Convolution { outputs, inputs, size, kernel, bias, stride, padding })
            }
            _ => Err(format!("{name} has the shape {shape:?}")),
        }
    };
    // torchvision.models.alexnet: places, kernel sizes, strides, paddings.
    let steps = [(0, 11, 4, 2), (3, 5, 1, 2), (6, 3, 1, 1), (8, 3, 1, 1), (10, 3, 1, 1)];
    for (place, size, stride, padding) in steps {
        if matches!(place, 3 | 6) {
            layers.push(Layer::Pool);
        }
        let name = format!("features.{place}");
        layers.push(Layer::Convolution(convolution(&name, size, stride, padding)?));
        layers.push(Layer::Tap);
    }
    let count = layers.iter().filter(|layer| matches!(layer, Layer::Tap)).count();
    let mut heads = Vec::new();
    for index in 0..count {
        let name = format!("lin{index}.weight");
        let (_, head) = tensors.remove(&name).ok_or_else(|| format!("{name} is missing"))?;
        heads.push(head);
    }
    let network = Lpips { layers, heads };
    network.chained()?;
    Ok(network)
}

impl Lpips {
    /// Checks that each layer takes as many channels as the one before gives.
    fn chained(&self) -> Result<(), String> {
        let (mut channels, mut taps) = (3, 0);
        for layer in &self.layers {
            let (takes, gives) = match layer {
                Layer::Convolution(one) => (one.inputs, one.outputs),
                Layer::Pool => (channels, channels),
                Layer::Tap => {
                    taps += 1;
                    (self.heads[taps - 1].len(), channels)
                }
            };
            if takes != channels {
                return Err(format!("a layer takes {takes} channels where {channels} come"));
            }
            channels = gives;
        }
        Ok(())
    }
}

/// What passes each tap on the way through the layers.
pub(super) fn run(layers: &[Layer], input: Tensor) -> Vec<Tensor> {
    let mut taps = Vec::new();
    let mut tensor = input;
    for layer in layers {
        tensor = match layer {
            Layer::Convolution(one) => one.apply(&tensor),
            Layer::Pool => tensor.pooled(),
            Layer::Tap => {
                taps.push(tensor.clone());
                tensor
            }
        };
    }
    taps
}
