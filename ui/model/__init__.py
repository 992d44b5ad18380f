"""What windows show and what people may do in them, without any Qt: values in, values out."""
