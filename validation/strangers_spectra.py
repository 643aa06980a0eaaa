STRANGERS: list = []
